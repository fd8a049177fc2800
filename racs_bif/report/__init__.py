"""The written report: results as one page of HTML."""
