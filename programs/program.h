/* What sgidec and sgi-info share: failures in one line, streams opened by name. */
#ifndef SGI_PROGRAM_H
#define SGI_PROGRAM_H

#include <sgi.h>
#include <stdio.h>

/* Exit codes, those of `sgi` (docs/cli.md). */
enum { DONE = 0, FAILED = 1, WRONG_USAGE = 2, BAD_PICTURE = 3, BAD_STREAM = 4, EXISTS = 6 };

/* How messages begin; set by main. */
extern const char *program_name;

/* Prints "PROGRAM: TEXT" on stderr. */
void complain(const char *format, ...);
/* The same, then ends the program. */
void fail(int code, const char *format, ...);

/* The exit code that a status stands for. */
int code_of(sgi_status status);

typedef struct input {
  sgi_stream *stream;
  FILE *file;
} input;

/* Opens a file, or stdin for "-". On failure prints a line and returns the exit code, else 0. */
int open_input(const char *name, int threads, input *opened);
void close_input(input *opened);

/* What a layout is called in reports: "rgb", "gray+alpha" ... */
const char *layout_name(int layout);

/* Names the option that getopt_long refused; ends the program. */
void refuse_option(char **arguments, int found);
/* The whole of an argument as a number from 0 to `most`; else ends the program. */
unsigned long whole_number(const char *option, const char *text, unsigned long most);

#endif
