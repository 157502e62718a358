#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <sgi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "program.h"
#ifdef _WIN32
#include <io.h>
#else
#define O_BINARY 0
#endif

static FILE *file;
static const char *target;
static char *volatile temporary; /* null where OUT is written as it is */

static void discard(void) {
  if (temporary) unlink(temporary);
}

static void end(int number) {
  discard();
  _exit(128 + number);
}

static void catch_signals(void) {
  signal(SIGINT, end);
  signal(SIGTERM, end);
#ifndef _WIN32
  signal(SIGPIPE, end);
#endif
}

static int is_stream(const char *name) {
  unsigned char start[8];
  FILE *found = fopen(name, "rb");
  size_t count = found ? fread(start, 1, sizeof start, found) : 0;
  if (found) fclose(found);
  return sgi_is_stream(start, count);
}

/* Refuses what must not be replaced. Returns whether OUT is a file, or will be one. */
static int check_target(const char *name, int force) {
  struct stat facts;
  if (stat(name, &facts)) return 1;
  if (S_ISDIR(facts.st_mode)) fail(WRONG_USAGE, "%s is a folder", name);
  if (!S_ISREG(facts.st_mode)) return 0;
  if (is_stream(name)) fail(WRONG_USAGE, "%s is a stream, no picture; name another OUT", name);
  if (!force) fail(EXISTS, "%s exists; give -f to overwrite it", name);
  return 1;
}

/* ".NAME.PID" in the folder of a file. */
static char *temporary_beside(const char *name) {
  const char *slash = strrchr(name, '/');
  const int folder = slash ? (int)(slash - name) + 1 : 0;
  const size_t room = strlen(name) + 32;
  char *made = malloc(room);
  if (!made) fail(FAILED, "no memory left");
  snprintf(made, room, "%.*s.%s.%ld", folder, name, name + folder, (long)getpid());
  return made;
}

static FILE *begin_stdout(int force) {
  if (isatty(fileno(stdout)) && !force) fail(WRONG_USAGE, "stdout is a terminal; give -f to write a picture to it");
#ifdef _WIN32
  _setmode(_fileno(stdout), _O_BINARY);
#endif
  return stdout;
}

FILE *begin_output(const char *name, int force) {
  target = name;
  atexit(discard);
  catch_signals();
  if (!strcmp(name, "-")) {
    target = "stdout";
    file = begin_stdout(force);
  } else if (!check_target(name, force)) {
    file = fopen(name, "wb");
  } else {
    temporary = temporary_beside(name); /* before it is there, so that no signal leaves it */
    int number = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_BINARY, 0666);
#ifndef _WIN32
    struct stat old; /* who may read that may read what replaces it, and nobody else */
    if (number >= 0 && !stat(name, &old)) fchmod(number, old.st_mode & 0777);
#endif
    file = number < 0 ? NULL : fdopen(number, "wb");
  }
  if (!file) fail(errno == ENOENT || errno == ENOTDIR ? WRONG_USAGE : BAD_PICTURE, "%s: %s", name, strerror(errno));
  return file;
}

void finish_output(void) {
  const int failed = ferror(file) || fflush(file);
  if (failed || fclose(file)) {
    file = NULL;
    fail(BAD_PICTURE, "%s: %s", target, strerror(errno));
  }
  file = NULL;
  if (!temporary) return;
#ifdef _WIN32
  remove(target);
#endif
  if (rename(temporary, target)) fail(BAD_PICTURE, "%s: %s", target, strerror(errno));
  temporary = NULL;
}
