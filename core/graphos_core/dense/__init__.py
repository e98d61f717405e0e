"""Room 4, dense matching: a depth for every pixel, and one cloud from all of them."""
