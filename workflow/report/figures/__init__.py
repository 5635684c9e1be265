"""What matplotlib draws, a file a chapter of the page; `style.py`, `contours.py` and `hover.py` serve them all."""
