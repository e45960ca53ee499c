"""The linear response of pin and plate to tractions and loads."""
