"""Trees of BehaviorTree.CPP v4: read from its XML into our documents, and written back."""
