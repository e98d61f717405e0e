"""The pages of the features tab: one file per page, named after it."""
