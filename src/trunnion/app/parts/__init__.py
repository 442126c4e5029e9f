"""What the views and the page are made of."""
