"""What a design comes to: its exact terms, margins and sensitivities, as one typed answer."""
