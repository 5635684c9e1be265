"""The surrogates of a study and how good they are: training, times, the trial of a read-out, measured rows."""
