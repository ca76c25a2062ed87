"""From YAML to a ticking, recorded tree: documents, builder, runner, recorder."""
