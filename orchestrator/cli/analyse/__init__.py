"""`fanfold analyse`: every module here without an underscore is one analysis on the command line."""
