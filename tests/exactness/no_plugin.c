/* A shared object that is no plug-in. */
extern int gnomonNoPlugin;
int gnomonNoPlugin = 1;
