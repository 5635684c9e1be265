"""Studies, the steps of the pipeline, the report and the command line."""
