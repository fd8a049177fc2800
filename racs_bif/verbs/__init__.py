"""What a user asks for, one file each: they run the layers below and return results."""
