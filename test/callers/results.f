C     Prints every number and word of every table that a case gives, a
C     line each with its table and column, then the report: what
C     results.c and results.py print, line by line. The case comes from
C     the standard input.
C
C       gfortran results.f $(pkg-config --cflags --libs gearsweep)
C
      PROGRAM RESULT
      INTEGER MAXTXT
      PARAMETER (MAXTXT=60000)
      CHARACTER*(MAXTXT) CASE, LIST
      CHARACTER*200 LINE, MESSAG
      CHARACTER*64 TABLE, COLUMN
      INTEGER LENGTH, INFO, WATCH(3), USED, FROM, TO
      INTEGER*8 STUDY, NONE
      DATA WATCH /3*0/
C
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
C
C     Each table and each column has a line of its own.
      CALL GS_TEXT(STUDY, 'tables', LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      FROM = 1
   30 TO = FROM + INDEX(LIST(FROM:LENGTH), CHAR(10)) - 1
      IF (LIST(FROM:FROM+9) .EQ. '{"name": "') THEN
        TABLE = LIST(FROM+10:FROM+8+INDEX(LIST(FROM+10:TO), '"'))
      ELSE IF (LIST(FROM:FROM+11) .EQ. '  {"name": "') THEN
        COLUMN = LIST(FROM+12:FROM+10+INDEX(LIST(FROM+12:TO), '"'))
        CALL SHOW(STUDY, TABLE, COLUMN)
      END IF
      FROM = TO + 1
      IF (FROM .LE. LENGTH) GO TO 30
C
      CALL GS_TEXT(STUDY, 'report', LIST, LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') LIST(:LENGTH-1)
      CALL GS_FREE(STUDY)
      IF (STUDY .NE. 0) STOP 1
      END
C
      SUBROUTINE SHOW(STUDY, TABLE, COLUMN)
      INTEGER*8 STUDY
      CHARACTER*(*) TABLE, COLUMN
      INTEGER MAXROW
      PARAMETER (MAXROW=200000)
      DOUBLE PRECISION VALUES(MAXROW)
      CHARACTER*200 WORD, MESSAG
      CHARACTER*130 NAME
      INTEGER ROWS, KIND, WIDTH, INFO, I, N
      SAVE VALUES
C
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
C
      SUBROUTINE CHECK(INFO, MESSAG)
      INTEGER INFO
      CHARACTER*(*) MESSAG
      IF (INFO .EQ. 0) RETURN
      WRITE (*, '(''info'', I2, '': '', A)') INFO, MESSAG
      STOP 1
      END
