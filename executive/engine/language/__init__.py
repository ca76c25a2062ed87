"""What a document says: its models, expressions, types, units and names."""
