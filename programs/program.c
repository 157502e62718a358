#include "program.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#define fseeko fseeko64
#endif

const char *program_name = "sgi";

static void print_line(const char *format, va_list values) {
  fprintf(stderr, "%s: ", program_name);
  vfprintf(stderr, format, values);
  fputc('\n', stderr);
}

void complain(const char *format, ...) {
  va_list values;
  va_start(values, format);
  print_line(format, values);
  va_end(values);
}

void fail(int code, const char *format, ...) {
  va_list values;
  va_start(values, format);
  print_line(format, values);
  va_end(values);
  exit(code);
}

int code_of(sgi_status status) {
  switch (status) {
    case SGI_OK: return DONE;
    case SGI_ERROR_USAGE:
    case SGI_ERROR_REGION: return WRONG_USAGE;
    case SGI_ERROR_CORRUPT:
    case SGI_ERROR_UNSUPPORTED:
    case SGI_ERROR_LIMIT:
    case SGI_ERROR_SOURCE: return BAD_STREAM;
    default: return FAILED;
  }
}

/* Of a pipe, offsets are where it is. */
static int64_t read_file(void *user, uint64_t offset, void *buffer, size_t count) {
  FILE *file = user;
  if (file != stdin && fseeko(file, (off_t)offset, SEEK_SET)) return -1;
  size_t found = fread(buffer, 1, count, file);
  return ferror(file) ? -1 : (int64_t)found;
}

/* The size of a file that can be read anywhere. */
static uint64_t size_of(FILE *file) {
  struct stat facts;
  if (file == stdin || fstat(fileno(file), &facts) || !S_ISREG(facts.st_mode)) return SGI_SIZE_UNKNOWN;
  return (uint64_t)facts.st_size;
}

static int refuse_input(const char *name, const char *text) {
  complain("%s: %s", name, text);
  return BAD_STREAM;
}

int open_input(const char *name, int threads, input *opened) {
  const int is_stdin = !strcmp(name, "-");
  const char *shown = is_stdin ? "stdin" : name;
  struct stat facts;
  opened->stream = NULL;
  opened->file = is_stdin ? stdin : fopen(name, "rb");
  if (!opened->file) return refuse_input(name, strerror(errno));
#ifdef _WIN32
  if (is_stdin) _setmode(_fileno(stdin), _O_BINARY);
#endif
  if (!fstat(fileno(opened->file), &facts) && S_ISDIR(facts.st_mode)) {
    close_input(opened);
    return refuse_input(shown, "Is a directory");
  }
  sgi_options options = SGI_OPTIONS_INIT;
  options.threads = threads;
  sgi_status status = sgi_open(read_file, opened->file, size_of(opened->file), &options, &opened->stream);
  if (status == SGI_OK) return DONE;
  complain("%s: %s", shown, sgi_error());
  close_input(opened);
  return code_of(status);
}

void close_input(input *opened) {
  sgi_close(opened->stream);
  if (opened->file != stdin) fclose(opened->file);
}

const char *layout_name(int layout) {
  static const char *const names[] = {"multi", "gray", "gray+alpha", "rgb", "rgba"};
  return names[layout];
}

void refuse_option(char **arguments, int found) {
  const char *text = arguments[optind - 1];
  if (found == ':') fail(WRONG_USAGE, "Option '%s' needs a value; see %s --help", text, program_name);
  if (optopt && isprint(optopt) && strncmp(text, "--", 2))
    fail(WRONG_USAGE, "No such option '-%c'; see %s --help", optopt, program_name);
  fail(WRONG_USAGE, "No such option '%s'; see %s --help", text, program_name);
}

unsigned long whole_number(const char *option, const char *text, unsigned long most) {
  char *end;
  errno = 0;
  unsigned long number = strtoul(text, &end, 10);
  if (!isdigit((unsigned char)*text) || *end || errno || number > most)
    fail(WRONG_USAGE, "Invalid value for '%s': '%s' is not a whole number from 0 to %lu", option, text, most);
  return number;
}
