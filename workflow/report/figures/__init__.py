"""What matplotlib draws, a file a chapter of the page."""
