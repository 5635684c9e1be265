"""The verdict on a design: exact terms, margins and sensitivities, as one typed answer."""
