/* A module of gdk-pixbuf, by which programs of GNOME and others that use it show .sgi streams. A stream is drawn at the
 * size that the program asks for, so that a thumbnail decodes no more than it shows. */
#define GDK_PIXBUF_ENABLE_BACKEND
#include <gdk-pixbuf/gdk-pixbuf.h>
#include <sgi.h>

#define MAX_SIDE 32767 /* as gdk-pixbuf bounds JPEG and others */

typedef struct {
  GByteArray *bytes;
  GdkPixbufModuleSizeFunc size_func;
  GdkPixbufModulePreparedFunc prepared_func;
  GdkPixbufModuleUpdatedFunc updated_func;
  gpointer user;
  gint width, height; /* to be drawn; 0 until the header is there */
} Loading;

static gboolean refuse(GError **error, GdkPixbufError code, const char *text) {
  g_set_error_literal(error, GDK_PIXBUF_ERROR, code, text);
  return FALSE;
}

static gboolean refuse_status(GError **error, sgi_status status) {
  const GdkPixbufError code = status == SGI_ERROR_MEMORY        ? GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY
                              : status == SGI_ERROR_UNSUPPORTED ? GDK_PIXBUF_ERROR_UNKNOWN_TYPE
                              : status == SGI_ERROR_CORRUPT     ? GDK_PIXBUF_ERROR_CORRUPT_IMAGE
                                                                : GDK_PIXBUF_ERROR_FAILED;
  return refuse(error, code, sgi_error());
}

static gpointer begin_load(GdkPixbufModuleSizeFunc size_func, GdkPixbufModulePreparedFunc prepared_func,
                           GdkPixbufModuleUpdatedFunc updated_func, gpointer user, GError **error) {
  (void)error;
  Loading *loading = g_new0(Loading, 1);
  loading->bytes = g_byte_array_new();
  loading->size_func = size_func, loading->prepared_func = prepared_func, loading->updated_func = updated_func;
  loading->user = user;
  return loading;
}

/* Asks the program for a size as soon as the header is there. */
static gboolean find_size(Loading *loading, GError **error) {
  sgi_info info = SGI_INFO_INIT;
  const sgi_status status = sgi_probe(loading->bytes->data, loading->bytes->len, &info);
  if (status == SGI_ERROR_SOURCE) return TRUE;
  if (status != SGI_OK) return refuse_status(error, status);
  loading->width = (gint)info.width, loading->height = (gint)info.height;
  if (loading->size_func) loading->size_func(&loading->width, &loading->height, loading->user);
  if (loading->width < 1 || loading->height < 1) return refuse(error, GDK_PIXBUF_ERROR_FAILED, "not asked for");
  if (loading->width > MAX_SIDE || loading->height > MAX_SIDE)
    return refuse(error, GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY, "the picture is too large; ask for a smaller size");
  return TRUE;
}

static gboolean load_increment(gpointer context, const guchar *bytes, guint size, GError **error) {
  Loading *loading = context;
  if (loading->bytes->len > G_MAXUINT - size)
    return refuse(error, GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY, "a stream of 4 GiB");
  g_byte_array_append(loading->bytes, bytes, size);
  return loading->width ? TRUE : find_size(loading, error);
}

static void keep_profile(sgi_stream *stream, GdkPixbuf *pixbuf) {
  const void *bytes;
  size_t size;
  if (sgi_get_metadata(stream, SGI_METADATA_ICC, &bytes, &size) != SGI_OK || !bytes) return;
  gchar *text = g_base64_encode(bytes, size);
  gdk_pixbuf_set_option(pixbuf, "icc-profile", text);
  g_free(text);
}

/* Null with an error. Without alpha and nodata, three samples a pixel. */
static GdkPixbuf *drawn(const Loading *loading, sgi_stream *stream, GError **error) {
  sgi_info info = SGI_INFO_INIT;
  sgi_status status = sgi_get_info(stream, &info);
  if (status != SGI_OK) return refuse_status(error, status), NULL;
  const gboolean is_plain = info.layout == SGI_LAYOUT_RGB && !info.has_nodata;
  GdkPixbuf *pixbuf = gdk_pixbuf_new(GDK_COLORSPACE_RGB, !is_plain, 8, loading->width, loading->height);
  if (!pixbuf) return refuse(error, GDK_PIXBUF_ERROR_INSUFFICIENT_MEMORY, "no memory for the picture"), NULL;
  sgi_view view = SGI_VIEW_INIT;
  view.width = info.width, view.height = info.height;
  view.columns = (uint32_t)loading->width, view.rows = (uint32_t)loading->height;
  view.pixels = is_plain ? SGI_PIXELS_CHANNELS : SGI_PIXELS_RGBA;
  status = sgi_draw(stream, &view, gdk_pixbuf_get_pixels(pixbuf), (size_t)gdk_pixbuf_get_rowstride(pixbuf));
  if (status == SGI_OK) return keep_profile(stream, pixbuf), pixbuf;
  g_object_unref(pixbuf);
  return refuse_status(error, status), NULL;
}

static gboolean finish(const Loading *loading, GError **error) {
  sgi_stream *stream;
  const sgi_status status = sgi_open_memory(loading->bytes->data, loading->bytes->len, NULL, &stream);
  if (status != SGI_OK) return refuse_status(error, status);
  GdkPixbuf *pixbuf = drawn(loading, stream, error);
  sgi_close(stream);
  if (!pixbuf) return FALSE;
  if (loading->prepared_func) loading->prepared_func(pixbuf, NULL, loading->user);
  if (loading->updated_func) loading->updated_func(pixbuf, 0, 0, loading->width, loading->height, loading->user);
  g_object_unref(pixbuf);
  return TRUE;
}

static gboolean stop_load(gpointer context, GError **error) {
  Loading *loading = context;
  const gboolean is_done = loading->width ? finish(loading, error)
                                          : refuse(error, GDK_PIXBUF_ERROR_CORRUPT_IMAGE,
                                                   "the file ends inside its header; it was cut short");
  g_byte_array_unref(loading->bytes);
  g_free(loading);
  return is_done;
}

G_MODULE_EXPORT void fill_vtable(GdkPixbufModule *module);
G_MODULE_EXPORT void fill_info(GdkPixbufFormat *info);

void fill_vtable(GdkPixbufModule *module) {
  module->begin_load = begin_load;
  module->load_increment = load_increment;
  module->stop_load = stop_load;
}

void fill_info(GdkPixbufFormat *info) {
  static GdkPixbufModulePattern signature[] = {{(char *)"\x89SGI\r\n\x1a\n", NULL, 100}, {NULL, NULL, 0}};
  static gchar *mime_types[] = {(gchar *)"image/x-sgicodec", NULL}, *extensions[] = {(gchar *)"sgi", NULL};
  info->name = (gchar *)"sgicodec";
  info->signature = signature;
  info->description = (gchar *)"sgicodec image";
  info->mime_types = mime_types;
  info->extensions = extensions;
  info->flags = GDK_PIXBUF_FORMAT_THREADSAFE;
  info->license = (gchar *)"BSD";
}
