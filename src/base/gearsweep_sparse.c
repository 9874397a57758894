/* MUMPS behind its C interface, which any compiler can call (a Fortran caller would have to share the array
   descriptors of the compiler that built MUMPS), and the mutexes of MUMPS and ARPACK.

   Both libraries keep state between and within calls: MUMPS in module variables, ARPACK in saved locals and common
   blocks. So one thread at a time is within a call of MUMPS, and one runs ARPACK's iteration from beginning to end.
   A thread that needs both locks ARPACK's mutex first. */
#include <dmumps_c.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

void gearsweep_begin_products(void);
void gearsweep_end_products(void);

static pthread_mutex_t mumps = PTHREAD_MUTEX_INITIALIZER;
static pthread_mutex_t arpack = PTHREAD_MUTEX_INITIALIZER;

/* Runs one of MUMPS' jobs, and returns its INFOG(1): below 0 if it failed. */
static int run(DMUMPS_STRUC_C *matrix, int job)
{
  matrix->job = job;
  pthread_mutex_lock(&mumps);
  gearsweep_begin_products();
  dmumps_c(matrix);
  gearsweep_end_products();
  pthread_mutex_unlock(&mumps);
  return matrix->infog[0];
}

/* Frees a matrix in any state. */
void gearsweep_sparse_free(DMUMPS_STRUC_C *matrix)
{
  if (!matrix) return;
  run(matrix, -2);
  free(matrix);
}

/* Orders the unknowns and plans the factor of a symmetric positive definite matrix of order n, the sum of `elements`
   dense ones: element e has the unknowns at[first[e] - 1 .. first[e + 1] - 2], counted from 1. Both arrays must live
   as long as the matrix. The `kept` unknowns `list`, which must live as long, are not eliminated. `bytes`: memory
   of the factorisation. `detail`: INFOG(2). */
DMUMPS_STRUC_C *gearsweep_sparse_analyse(int n, int elements, int *first, int *at, int kept, int *list, double *bytes,
                                         int *info, int *detail)
{
  DMUMPS_STRUC_C *matrix = calloc(1, sizeof *matrix);
  *bytes = *detail = 0;
  *info = -13;
  if (!matrix) return 0;
  matrix->sym = 1;
  matrix->par = 1;
  matrix->comm_fortran = -987654; /* MUMPS' name for the world of its MPI stub */
  *info = run(matrix, -1);
  if (*info < 0) {
    free(matrix);
    return 0;
  }
  matrix->icntl[0] = matrix->icntl[1] = matrix->icntl[2] = -1; /* prints nothing */
  matrix->icntl[3] = 0;
  matrix->icntl[4] = 1;  /* matrix as elements */
  matrix->icntl[6] = 0;  /* approximate minimum degree: the quickest, and little more fill than the best */
  matrix->icntl[7] = 0;  /* no scaling: a positive definite matrix needs none */
  matrix->n = n;
  matrix->nelt = elements;
  matrix->eltptr = first;
  matrix->eltvar = at;
  if (kept > 0) {
    matrix->icntl[18] = 1; /* matrix of the kept unknowns after elimination of the others, as one array */
    matrix->size_schur = kept;
    matrix->listvar_schur = list;
  }
  *info = run(matrix, 1);
  *detail = matrix->infog[1];
  *bytes = 1e6*matrix->infog[15];
  return matrix;
}

/* Factors the matrix: `values` has the lower triangle of each element, column after column. `schur`: matrix of the kept
   unknowns, if any; of each row, the part up to the diagonal. `negative`: number of negative pivots. */
int gearsweep_sparse_factor(DMUMPS_STRUC_C *matrix, double *values, double *schur, int *negative, int *detail)
{
  int info;
  matrix->a_elt = values;
  matrix->schur = schur;
  info = run(matrix, 2);
  matrix->a_elt = 0;
  matrix->schur = 0;
  *negative = matrix->infog[11];
  *detail = matrix->infog[1];
  return info;
}

/* Solves in place for `columns` right sides at a time, of `sides`. With kept unknowns, `part` 1 stores
   their reduced right sides in `kept`; after it, `part` 2 reads their values from `kept` and computes all others. Without
   kept unknowns `part` is 0. */
int gearsweep_sparse_solve(DMUMPS_STRUC_C *matrix, int sides, int columns, double *x, int part, double *kept, int *detail)
{
  int info;
  pthread_mutex_lock(&mumps);
  matrix->icntl[25] = part;
  matrix->redrhs = kept;
  matrix->lredrhs = matrix->size_schur;
  matrix->icntl[26] = columns;
  matrix->rhs = x;
  matrix->nrhs = sides;
  matrix->lrhs = matrix->n;
  matrix->job = 3;
  gearsweep_begin_products();
  dmumps_c(matrix);
  gearsweep_end_products();
  matrix->rhs = matrix->redrhs = 0;
  info = matrix->infog[0];
  *detail = matrix->infog[1];
  pthread_mutex_unlock(&mumps);
  return info;
}

void gearsweep_enter_arpack(void) { pthread_mutex_lock(&arpack); }

void gearsweep_leave_arpack(void) { pthread_mutex_unlock(&arpack); }
