/* gearsweep for C and C++: eleven calls, whose arguments never change.
 *
 * But for gsc_free, every call returns a code and leaves a message, which is empty where the code is 0.
 *
 *   text, text_length      the case, as the program reads it: text_length bytes, or up to the first NUL.
 *   study                  what gsc_run found. The caller owns it: it stays until gsc_free. Any number of threads may
 *                          read one study at once, and each may run its own.
 *   table, column          their names, as in the files NAME.TABLE.csv and in gsc_text's list; a misspelt one is
 *                          answered with the closest.
 *   buffer, buffer_size    where a text goes, with its NUL; lines end with \n. length: that of the text, without its
 *                          NUL; told also where the buffer is too small (then GSC_INPUT, and it stays as it was). NULL:
 *                          not wanted.
 *   message, message_size  where the message goes, with its NUL; cut where it is too long. NULL and 0: not wanted.
 *
 * Nothing prints, exits or keeps state. While a study runs, OpenBLAS is kept to one thread; the number before comes back
 * when the last run ends.
 */
#ifndef GEARSWEEP_H
#define GEARSWEEP_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The codes, the same for the program (its exit code), Fortran, C and Python. Unless the code is GSC_OK, GSC_PARTIAL or
   GSC_INTERRUPTED, the results are as they were. */
enum {
  GSC_OK = 0,
  GSC_INPUT = 1,        /* the case or an argument is not usable; room too small: the message has the size */
  GSC_USAGE = 2,        /* the command line is not usable (program only) */
  GSC_FILE = 3,         /* a file or folder cannot be read or written */
  GSC_PARTIAL = 4,      /* some operating points have no answer (NaN); the others were computed */
  GSC_NUMERICAL = 5,    /* a numerical method did not deliver, although the input is valid */
  GSC_MEMORY = 6,       /* the work does not fit into the memory */
  GSC_INTERRUPTED = 130 /* the caller ended the run; what was done by then is there */
};

/* What a column holds: numbers for gsc_column, or words for gsc_words. */
enum { GSC_REAL = 1, GSC_INTEGER = 2, GSC_TEXT = 3 };

typedef struct gsc_study gsc_study;

/* Version of the library, as "0.1.0". */
int gsc_version(char *buffer, size_t buffer_size, char *message, size_t message_size);

/* What the library has, as text in JSON. what: "tasks", what a case can ask for; "groups" and "keys", what a case may say,
   with units, defaults and bounds; "key GROUP KEY", one of the keys; "all", these three; "tables", the tables there can be. */
int gsc_describe(const char *what, char *buffer, size_t buffer_size, size_t *length, char *message, size_t message_size);

/* Works on the text of a case. action:
   "complete"  the case with every key that it leaves to its default written out; it gives the same result
   "change"    the case with another value of one key; the rest of the text stays as it is, with its remarks. group, key:
               without &; a group that is missing is added; value: as it stands in a case, such as "0, 5, 10" or "'fe'";
               empty: the key is taken out. A key that no case has is refused, with the closest, unless it is taken out
               of a text that has it. Whether this case allows the key and the value is told by the run.
               With group and key empty, value has several keys as a case has them, such as
               "&load line_load_n_mm = 250 / &relief amount_um = 0, 5 /"
   "unused"    the keys that the case gives but does not use, mostly for tasks that it does not name: for each use that
               they would have, a line "use: &group key, key; &group key"
   "new"       a case for the tasks in text, separated by blanks, with every key of theirs and its default
   "table"     not of a case: the rows of a table in text, which may be written as doc/case.md tells of tables, as JSON:
               [[line, name, name ...], [line, field, field ...] ...]; key is its name for messages
   Else only "change" takes group, key and value; NULL is empty. */
int gsc_edit(const char *action, const char *text, size_t text_length, const char *group, const char *key,
             const char *value, char *buffer, size_t buffer_size, size_t *length, char *message, size_t message_size);

/* Runs a case: all its tasks.
   folder   where files that the case names lie; NULL or empty: the current folder
   threads  of the sweep; 0: all. The results are the same for any number
   earlier  a study whose products are taken over where they were made from the same inputs, so that they cost nothing;
            the results are the same bits as without. It stays as it is. NULL: none
   watch[3] watch[0] is 0; whoever sets it to another number while the call computes, a signal's handler or another
            thread, ends the run soon (GSC_INTERRUPTED; points that are not computed have the status "stopped" and NaN).
            watch[1]: operating points done so far, never fewer than before, watch[2]: of how many. NULL: not watched
   resume, keep  NULL or empty. They named files for resuming a run in earlier versions; any text is refused (GSC_INPUT), as a
            single run is no longer resumed
   study    what was found; untouched after an error */
int gsc_run(const char *text, size_t text_length, const char *folder, int threads, const gsc_study *earlier, int *watch,
            const char *resume, const char *keep, gsc_study **study, char *message, size_t message_size);

/* Runs a case once for each row of values of some of its keys. Its text is read once, and what an earlier row has of the same
   inputs is taken over; each row gives the same bits as the case with its values run alone.
   text, folder, threads, earlier, watch as of gsc_run; watch[1]: rows done, watch[2]: of how many
   names    the keys, each as group.key, with blanks between them, such as "load.line_load_n_mm relief.amount_um"; each takes one
            number: of a list, the only one
   rows     how many, at least 1
   values   those of the first row, one for each name, then those of the second, and so on. A key that takes integers takes
            whole numbers
   take     the columns that are wanted, each as table.column, with blanks between them; numbers, no words. How many rows a table
            has is told by the first row of values that runs
   study    has the table "rows" with a code and a message for each row of values ("code", "message"), and of the tables in take these
            columns, which hold all their numbers of the first row of values, then those of the second, and so on, as GSC_REAL;
            NaN for a row without a result. It has no texts but "tables", no files, and can be the earlier of others. A column that is not there
            is an error of the call; where rows have a code other than GSC_OK it ends with GSC_PARTIAL, or GSC_INTERRUPTED */
int gsc_rows(const char *text, size_t text_length, const char *folder, int threads, const gsc_study *earlier, int *watch,
             const char *names, int rows, const double *values, const char *take, gsc_study **study, char *message,
             size_t message_size);

/* One of the texts of a study. what: "report", what the program prints; "log", which stages ran, which were taken over and
   which left out, a line each; "tables", in JSON, the tables with their columns, units and meanings; "case", the case
   that was run. */
int gsc_text(const gsc_study *study, const char *what, char *buffer, size_t buffer_size, size_t *length, char *message,
             size_t message_size);

/* How many rows a table has, and what a column of it holds. kind: GSC_REAL ...; width: of the longest words, without
   their NUL, 0 for numbers. */
int gsc_size(const gsc_study *study, const char *table, const char *column, int *rows, int *kind, int *width,
             char *message, size_t message_size);

/* The numbers of a column, in the unit that its name ends with; NaN where there is no result. rows: room in values, at
   least the table's rows; what lies beyond those is not touched. */
int gsc_column(const gsc_study *study, const char *table, const char *column, int rows, double *values, char *message,
               size_t message_size);

/* The words of a column in one row, which is counted from 0. */
int gsc_words(const gsc_study *study, const char *table, const char *column, int row, char *buffer, size_t buffer_size,
              char *message, size_t message_size);

/* Writes the tables and grids of a study as files name.TABLE.csv and name.GRID.vtu into a folder, which is made if
   missing: all, or none where one cannot be written (GSC_FILE), and then what was there before stays. Calls at once into
   one folder are served one after the other. Files of an earlier call with this name that this study has not get the ending
   .old. name: without a folder and control characters. buffer: the files written, a line each, also where it is too small. */
int gsc_write(const gsc_study *study, const char *folder, const char *name, char *buffer, size_t buffer_size,
              size_t *length, char *message, size_t message_size);

/* Frees a study, which nobody may read meanwhile, and sets it to NULL; one that is NULL stays. */
void gsc_free(gsc_study **study);

#ifdef __cplusplus
}
#endif

#endif
