"""Results as files that other programs read: pictures in space that move, fields, tables, matrices."""
