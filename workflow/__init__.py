"""What an engineer asks for: studies, the pipeline's steps, the report and the command line."""
