"""From a design question to its verdict: scenarios, risk, search, exact assessment, words."""
