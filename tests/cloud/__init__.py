"""The pipeline without a shared disk."""
