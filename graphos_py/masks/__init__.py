"""Drawing masks on photos: what is excluded from measuring, as polygons."""
