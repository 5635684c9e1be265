"""The half-plane in closed form: surface response, contact, fields, punch response."""
