C     Prints every number and word of every table that a case gives, a
C     line each with its table and column, then the report, runs the case
C     again from the first study, and two rows of values, of which the
C     second is refused, as is a run from a file of an interrupted one:
C     what results.c and results.py print, line by line. The case comes
C     from the standard input.
C
C       gfortran results.f $(pkg-config --cflags --libs gearsweep)
C
      PROGRAM RESULT
      INTEGER MAXTXT
      PARAMETER (MAXTXT=60000)
      CHARACTER*(MAXTXT) CASE, LIST, OTHER
      CHARACTER*200 LINE, MESSAG
      CHARACTER*64 TABLE, COLUMN
      INTEGER LENGTH, INFO, WATCH(3), USED, FROM, TO
      INTEGER*8 STUDY, AGAIN, NONE
      DOUBLE PRECISION VALUES(4)
      DATA WATCH /3*0/
      DATA VALUES /5D0, 0.25D0, -1D0, 0.25D0/
      CASE = ' '
      USED = 0
   10 READ (*, '(A)', END=20) LINE
      CASE(USED+1:) = LINE
      USED = USED + LEN(LINE) + 1
      CASE(USED:USED) = CHAR(10)
      GO TO 10
   20 NONE = 0
      STUDY = 0
      CALL GS_RUN(CASE(:USED), ' ', 2, NONE, WATCH, ' ', ' ', STUDY,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
C     Each table and each column has a line of its own.
      CALL GS_TEXT(STUDY, 'tables', LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      FROM = 1
   30 TO = FROM + INDEX(LIST(FROM:LENGTH), CHAR(10)) - 1
      IF (LIST(FROM:FROM+9) .EQ. '{"name": "') THEN
        TABLE = LIST(FROM+10:FROM+8+INDEX(LIST(FROM+10:TO), '"'))
      ELSE IF (LIST(FROM:FROM+11) .EQ. '  {"name": "') THEN
        COLUMN = LIST(FROM+12:FROM+10+INDEX(LIST(FROM+12:TO), '"'))
        IF (INDEX(LIST(FROM:TO), '"reproducible": false') .EQ. 0) THEN
          CALL SHOW(STUDY, TABLE, COLUMN)
        ELSE
          WRITE (*, '(3A)') TABLE(:LEN_TRIM(TABLE)), '.',
     1      COLUMN(:LEN_TRIM(COLUMN))
        END IF
      END IF
      FROM = TO + 1
      IF (FROM .LE. LENGTH) GO TO 30
      CALL GS_TEXT(STUDY, 'report', LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') LIST(:LENGTH-1)
      CALL GS_EDIT('change', CASE(:USED), 'case', 'title', '''again''',
     1  OTHER, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      AGAIN = 0
      CALL GS_RUN(OTHER(:LENGTH), ' ', 1, STUDY, WATCH, ' ', ' ', AGAIN,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      NONE = 0
      CALL GS_RUN(OTHER(:LENGTH), ' ', 1, STUDY, WATCH, 'x', ' ', NONE,
     1  INFO, MESSAG)
      IF (INFO .NE. 1 .OR. NONE .NE. 0) STOP 1
      WRITE (*, '(A)') MESSAG(:LEN_TRIM(MESSAG))
      CALL GS_TEXT(AGAIN, 'log', LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') LIST(:LENGTH-1)
      CALL GETARG(1, OTHER)
      CALL GS_WRITE(AGAIN, 'written', OTHER, LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') LIST(:LENGTH-1)
      CALL GS_FREE(AGAIN)
      CALL GS_EDIT('change', CASE(:USED), 'case', 'tasks', '''mesh''',
     1  OTHER, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL GS_ROWS(OTHER(:LENGTH), ' ', 1, STUDY, WATCH,
     1  'relief.amount_um dynamics.damping_ratio', 2, VALUES,
     2  'motion.natural_frequency_hz', AGAIN, INFO, MESSAG)
      IF (INFO .NE. 4) STOP 1
      WRITE (*, '(A)') MESSAG(:LEN_TRIM(MESSAG))
      CALL GS_WORDS(AGAIN, 'rows', 'message', 2, LINE, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') LINE(:LEN_TRIM(LINE))
      CALL GS_COLUMN(AGAIN, 'motion', 'natural_frequency_hz', 2, VALUES,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(''rows of motion.natural_frequency_hz,'', ES25.16E3)')
     1  VALUES(1), VALUES(2)
      CALL GS_FREE(AGAIN)
      CALL GS_FREE(STUDY)
      IF (STUDY .NE. 0) STOP 1
      END
      SUBROUTINE SHOW(STUDY, TABLE, COLUMN)
      INTEGER*8 STUDY
      CHARACTER*(*) TABLE, COLUMN
      INTEGER MAXROW
      PARAMETER (MAXROW=200000)
      DOUBLE PRECISION VALUES(MAXROW)
      CHARACTER*400 WORD
      CHARACTER*200 MESSAG
      CHARACTER*130 NAME
      INTEGER ROWS, KIND, WIDTH, INFO, I, N
      SAVE VALUES
      NAME = TABLE(:INDEX(TABLE, ' ')-1)//'.'//COLUMN
      N = INDEX(NAME, ' ') - 1
      CALL GS_SIZE(STUDY, TABLE, COLUMN, ROWS, KIND, WIDTH, INFO,
     1  MESSAG)
      CALL CHECK(INFO, MESSAG)
      IF (KIND .EQ. 3) THEN
        DO 10 I = 1, ROWS
          CALL GS_WORDS(STUDY, TABLE, COLUMN, I, WORD, INFO, MESSAG)
          CALL CHECK(INFO, MESSAG)
          WRITE (*, '(A, '','', A)') NAME(:N), WORD(:LEN_TRIM(WORD))
   10   CONTINUE
      ELSE
        CALL GS_COLUMN(STUDY, TABLE, COLUMN, MAXROW, VALUES, INFO,
     1    MESSAG)
        CALL CHECK(INFO, MESSAG)
        DO 20 I = 1, ROWS
          WRITE (*, '(A, '','', ES25.16E3)') NAME(:N), VALUES(I)
   20   CONTINUE
      END IF
      END
      SUBROUTINE CHECK(INFO, MESSAG)
      INTEGER INFO
      CHARACTER*(*) MESSAG
      IF (INFO .EQ. 0) RETURN
      WRITE (*, '(''info'', I2, '': '', A)') INFO, MESSAG
      STOP 1
      END
