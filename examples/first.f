C     Which relief is best? The worst dynamic factor over the speeds,
C     for each relief.
      PROGRAM FIRST
      INTEGER MAXREL
      PARAMETER (MAXREL = 20)
      CHARACTER*400 TEXT
      CHARACTER*120 MESSAG
      INTEGER*8 STUDY, NONE
      INTEGER WATCH(3), NREL, KIND, WIDTH, INFO, I
      DOUBLE PRECISION RELIEF(MAXREL), FACTOR(MAXREL), RPM(MAXREL)
      TEXT = '&case tasks = "sweep" / &pair module_mm = 3 '
     1  // 'face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34'
     2  // ' / &load torque_nm = 100 / &relief amount_um = 0, 10, 20 /'
     3  // ' &sweep rpm_first = 1000 '
     4  // 'rpm_last = 15000 rpm_step = 500 /'
      STUDY = 0
      NONE = 0
      WATCH(1) = 0
      CALL GS_RUN(TEXT, ' ', 0, NONE, WATCH, ' ', ' ', STUDY, INFO,
     1  MESSAG)
C     4: some operating points have no result; the others have.
      IF (INFO .EQ. 4) WRITE (*, '(A)') MESSAG
      IF (INFO .EQ. 4) INFO = 0
      IF (INFO .EQ. 0) CALL GS_SIZE(STUDY, 'sweep_worst', 'rpm', NREL,
     1  KIND, WIDTH, INFO, MESSAG)
      IF (INFO .EQ. 0) CALL GS_COLUMN(STUDY, 'sweep_worst', 'relief_um',
     1  MAXREL, RELIEF, INFO, MESSAG)
      IF (INFO .EQ. 0) CALL GS_COLUMN(STUDY, 'sweep_worst',
     1  'worst_dynamic_factor', MAXREL, FACTOR, INFO, MESSAG)
      IF (INFO .EQ. 0) CALL GS_COLUMN(STUDY, 'sweep_worst', 'rpm',
     1  MAXREL, RPM, INFO, MESSAG)
      IF (INFO .NE. 0) THEN
        WRITE (*, '(A)') MESSAG
        STOP 1
      END IF
      WRITE (*, 10) (RELIEF(I), FACTOR(I), RPM(I), I = 1, NREL)
   10 FORMAT (F5.1, ' um: worst dynamic factor', F8.4, ' at', F8.1,
     1  ' rpm')
      CALL GS_FREE(STUDY)
      END
