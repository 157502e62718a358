/* The region and the size that options ask for, as `sgi decode` takes them. */
#ifndef SGI_VIEWS_H
#define SGI_VIEWS_H

#include <sgi.h>

typedef struct view_options {
  int has_region, boundless;
  long long region[4]; /* X, Y, W, H in pixels of the picture */
  double scale;        /* 0: none given */
  unsigned size[2];    /* W, H; 0: none given */
  int is_exact_size;
} view_options;

/* These end the program with 2 for what makes no sense. */
void parse_region(view_options *options, const char *text);
void parse_scale(view_options *options, const char *text);
void parse_size(view_options *options, const char *text);
/* What is to be drawn of a picture; a region is cut where the picture ends, with a line on stderr. */
sgi_view view_of(const view_options *options, const sgi_info *info);

#endif
