"""One script for each figure: ``compute`` solves, ``draw`` draws. Installed as ``fastpin.figures``."""
