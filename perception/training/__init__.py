"""Train the learned parts of perception on images that are made here, never on photographs."""
