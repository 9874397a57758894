/* What the calls made by f2py share. */
#include <fortranobject.c>
