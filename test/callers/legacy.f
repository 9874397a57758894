C     Designs a spur-gear pair with gearsweep, as a legacy code would:
C     Fortran 77, fixed form. It runs a case, reads its results by name,
C     tries more relief on the same study, and leaves its files in
C     designed/.
C
C       gfortran legacy.f $(pkg-config --cflags --libs gearsweep)
C
      PROGRAM LEGACY
      CHARACTER*1000 CASE, AGAIN
      CHARACTER*3000 FILES
      CHARACTER*120 MESSAG
      CHARACTER*20 STATUS
      INTEGER*8 STUDY, RELVED, NONE
      INTEGER WATCH(3), TEETH(2), LENGTH, INFO
      DOUBLE PRECISION MODUL, WIDTH, FORCE, FREQ(1), LARGST
      EXTERNAL LARGST
      DATA WATCH /3*0/
C
C     The case, from the variables of this program.
      MODUL = 3.18D0
      WIDTH = 25.4D0
      TEETH(1) = 25
      TEETH(2) = 31
      FORCE = 7010D0
      WRITE (CASE, 100) MODUL, WIDTH, TEETH, FORCE
  100 FORMAT ('&case tasks = ''mesh'', ''sweep'' / ',
     1  '&pair module_mm = ', F6.3, ' face_width_mm = ', F8.3, ' / ',
     2  '&pinion teeth = ', I4, ' effective_mass_kg = 0.8 / ',
     3  '&gear teeth = ', I4, ' effective_mass_kg = 1.1 / ',
     4  '&load normal_force_n = ', F10.2, ' / ',
     5  '&mesh model = ''fe'' / &section elements_across = 6 / ',
     6  '&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 500 /')
      NONE = 0
      STUDY = 0
      CALL GS_RUN(CASE, ' ', 0, NONE, WATCH, ' ', ' ', STUDY, INFO,
     1  MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL GS_COLUMN(STUDY, 'motion', 'natural_frequency_hz', 1, FREQ,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL GS_WORDS(STUDY, 'sweep', 'status', 1, STATUS, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      PRINT 200, 'natural frequency', FREQ(1)
      PRINT 200, 'largest dynamic factor', LARGST(STUDY)
      PRINT 300, 'first point', STATUS(:INDEX(STATUS, ' ')-1)
  200 FORMAT (A, ',', ES24.16E2)
  300 FORMAT (A, ',', A)
C
C     Another relief: the stiffness is taken over from the first study.
      CALL GS_EDIT('change', CASE, 'relief', 'amount_um', '20', AGAIN,
     1  LENGTH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      RELVED = 0
      CALL GS_RUN(AGAIN, ' ', 0, STUDY, WATCH, ' ', ' ', RELVED, INFO,
     1  MESSAG)
      CALL CHECK(INFO, MESSAG)
      PRINT 200, 'largest dynamic factor', LARGST(RELVED)
      CALL GS_WRITE(RELVED, 'designed', 'pair', FILES, LENGTH, INFO,
     1  MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') FILES(:LENGTH-1)
      CALL GS_FREE(RELVED)
      CALL GS_FREE(STUDY)
      END
C
C     The largest dynamic factor of a study.
      DOUBLE PRECISION FUNCTION LARGST(STUDY)
      INTEGER*8 STUDY
      INTEGER MAXROW
      PARAMETER (MAXROW=1000)
      DOUBLE PRECISION FACTOR(MAXROW)
      CHARACTER*120 MESSAG
      INTEGER ROWS, KIND, WIDTH, INFO, I
      CALL GS_SIZE(STUDY, 'sweep', 'dynamic_factor', ROWS, KIND, WIDTH,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL GS_COLUMN(STUDY, 'sweep', 'dynamic_factor', MAXROW, FACTOR,
     1  INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      LARGST = FACTOR(1)
      DO 10 I = 2, ROWS
        IF (FACTOR(I) .GT. LARGST) LARGST = FACTOR(I)
   10 CONTINUE
      END
C
      SUBROUTINE CHECK(INFO, MESSAG)
      INTEGER INFO
      CHARACTER*(*) MESSAG
      IF (INFO .EQ. 0) RETURN
      PRINT *, 'info', INFO, ': ', MESSAG
      STOP 1
      END
