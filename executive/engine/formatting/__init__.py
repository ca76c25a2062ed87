"""The canonical form of a document: same meaning, same comments, one way to write it."""
