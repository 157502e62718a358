"""What the help of the group says, examples and exit codes; what others say of too little memory."""

from __future__ import annotations

EXAMPLES = (
    ("sgi encode photo.jpg", "photo.sgi beside it"),
    ("sgi decode photo.sgi", "photo.png beside it"),
    ("sgi info photo.sgi", "what it holds"),
)

EXIT_CODES = (
    (0, "done"),
    (1, "internal error, a report that cannot be written, or a benchmark point, a tile or a file of many that failed"),
    (2, "arguments or settings that make no sense"),
    (3, "a picture that cannot be read, or a picture or stream that cannot be written"),
    (4, "a stream that is damaged, unsupported or cannot be opened"),
    (5, "a target that was missed"),
    (6, "the output exists and -f was not given, or another encode is writing it"),
    (130, "interrupted, nothing written"),
    (141, "the reader of a pipe went away"),
)

NO_MEMORY = (
    *("failed to map segment", "cannot map zero-fill pages", "cannot change memory protections"),
    *("annot allocate memory", "can't start new thread", "temporarily unavailable"),
)
"""What libraries, the loader and threads say where there is not enough."""
