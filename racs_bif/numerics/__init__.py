"""Newton's method, bordered solves, root bracketing: thin layers over numpy and LAPACK."""
