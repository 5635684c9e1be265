"""A page that calculates a contact in the browser: the library, closed forms and tables of a few films in one file."""
