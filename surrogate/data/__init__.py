"""Inputs, query points and complete factorials: what every surrogate is made from and asked at."""
