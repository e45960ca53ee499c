"""What is asked of a result beside its states: one file for each question."""
