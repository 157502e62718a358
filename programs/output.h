/* The file that a program writes: complete under its name, or not there. */
#ifndef SGI_OUTPUT_H
#define SGI_OUTPUT_H

#include <stdio.h>

/* Begins OUT under a temporary name beside it, or stdout for "-". Ends the program with 6 where OUT exists and `force`
 * is 0, with 2 where OUT is a stream, a folder or in none, or a terminal. Devices and pipes are written as they are.
 * What is unfinished when the program ends, by a signal, too, is removed. */
FILE *begin_output(const char *name, int force);
/* Gives OUT its name; ends the program with 3 where not all could be written. */
void finish_output(void);

#endif
