"""The tiles of a stream: tasks and passes over them, who does them, and where finished ones are kept."""
