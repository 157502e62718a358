"""Pictures to streams: settings, plan, the passes over tiles, what each tile goes through."""
