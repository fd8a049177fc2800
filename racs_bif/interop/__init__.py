"""To and from python-control: its objects out of our results, our models out of its systems."""
