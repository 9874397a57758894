C     Prints every number that gearsweep has for a case, a line each with
C     its name and 17 digits, then the answer: what results.c and
C     results.py print, line by line. The case comes from the standard
C     input; a task that it does not name is left out.
C
C       gfortran results.f $(pkg-config --cflags --libs gearsweep)
C
      PROGRAM RESULT
      INTEGER MAXX, MAXWRK
      PARAMETER (MAXX=60000, MAXWRK=5000)
      CHARACTER*40000 CASE, ANSWER
      CHARACTER*300 LINE, MESSAG
      INTEGER NSPD, NREL, NROW, NTRY, NPOS, NMODE, NNODE, NELEM
      INTEGER NHARM, NWORK, INFO, I, N, LENGTH, K(MAXX, 4)
      DOUBLE PRECISION X(MAXX, 19), WORK(MAXWRK)
      LOGICAL ASKS
C
      CASE = ' '
      LENGTH = 0
   10 READ (*, '(A)', END=20) LINE
      CASE(LENGTH + 1:) = LINE
      LENGTH = LENGTH + LEN(LINE) + 1
      CASE(LENGTH:LENGTH) = CHAR(10)
      GOTO 10
   20 CALL GS_SIZES(CASE, ' ', NSPD, NREL, NROW, NTRY, NPOS, NMODE,
     1  NNODE, NELEM, NHARM, NWORK, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      IF (MAX(NSPD*NREL, NROW, NTRY, 6*NPOS*NREL, 8*NELEM,
     1  2*NNODE*MAX(NMODE, 2)).GT.MAXX .OR. NWORK.GT.MAXWRK)
     2  STOP 'ARRAYS TOO SMALL'
C
      IF (INDEX(CASE, 'contact_ratio').EQ.0) THEN
        CALL GS_GEOMETRY(CASE, X, X(1, 2), X(1, 3), X(1, 4), X(1, 5),
     1    X(1, 6), X(1, 7), X(1, 8), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('geometry.radius_mm', X, 12)
        CALL SHOW('geometry.point', X(1, 2), 5)
        CALL SHOW('geometry.point_radius_mm', X(1, 3), 10)
        CALL SHOW('geometry.distance_mm', X(1, 4), 1)
        CALL SHOW('geometry.working_angle_deg', X(1, 5), 2)
        CALL SHOW('geometry.contact_ratio', X(1, 6), 1)
        CALL SHOW('geometry.base_pitch_mm', X(1, 7), 1)
        CALL SHOW('geometry.backlash_um', X(1, 8), 1)
        DO 30 I = 1, 2
          CALL GS_OUTLINE(CASE, I, MAXX, N, X, X(1, 2), INFO, MESSAG)
          CALL CHECK(INFO, MESSAG)
          CALL SHOW('outline.x_mm', X, N)
          CALL SHOW('outline.y_mm', X(1, 2), N)
   30   CONTINUE
      END IF
C
      IF (NWORK.GT.0) THEN
        CALL GS_PREPARE(CASE, ' ', NWORK, WORK, INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL GS_MOTION(CASE, NWORK, WORK, X, X(1, 2), X(1, 3), X(1, 4),
     1    X(1, 5), X(1, 6), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('motion.load_n', X, 1)
        CALL SHOW('motion.mass_kg', X(1, 2), 2)
        CALL SHOW('motion.stiffness_n_um', X(1, 3), 1)
        CALL SHOW('motion.frequency_hz', X(1, 4), 1)
        CALL SHOW('motion.turn_um', X(1, 5), 1)
        CALL SHOW('motion.shared_um', X(1, 6), 1)
      END IF
C
      IF (ASKS(CASE, 'mesh')) THEN
        CALL GS_MESH(CASE, NWORK, WORK, NROW, X, X(1, 2), X(1, 3),
     1    X(1, 4), X(1, 5), X(1, 6), X(1, 7), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('mesh.relief_um', X, NROW)
        CALL SHOW('mesh.s', X(1, 2), NROW)
        CALL SHOW('mesh.pair_n_um', X(1, 3), NROW)
        CALL SHOW('mesh.mesh_n_um', X(1, 4), NROW)
        CALL SHOW('mesh.error_um', X(1, 5), NROW)
        CALL SHOW('mesh.share', X(1, 6), NROW)
        CALL SHOW('mesh.ste_um', X(1, 7), NROW)
        CALL GS_HARMONICS(CASE, NWORK, WORK, NHARM, NREL, X, X(1, 2),
     1    X(1, 3), X(1, 4), X(1, 5), X(1, 6), X(1, 7), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('harmonics.relief_um', X, NREL)
        CALL SHOW('harmonics.mean_um', X(1, 2), NREL)
        CALL SHOW('harmonics.rms_um', X(1, 3), NREL)
        CALL SHOW('harmonics.peak_to_peak_um', X(1, 4), NREL)
        CALL SHOW('harmonics.amplitude_um', X(1, 5), NHARM*NREL)
        CALL SHOW('harmonics.phase_deg', X(1, 6), NHARM*NREL)
        CALL SHOW('harmonics.estimate_um', X(1, 7), NREL)
      END IF
C
      IF (ASKS(CASE, 'load')) THEN
        CALL GS_LOAD(CASE, NWORK, WORK, MAXX, N, X, X(1, 2), X(1, 3),
     1    X(1, 4), X(1, 5), K, K(1, 2), K(1, 3), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('load.relief_um', X, N)
        CALL SHOW('load.rpm', X(1, 2), N)
        CALL SHOW('load.s', X(1, 3), N)
        CALL SHOW('load.pair_load_n', X(1, 4), N)
        CALL SHOW('load.dte_um', X(1, 5), N)
        CALL COUNT('load.status', K, N)
        CALL COUNT('load.periods', K(1, 2), N)
        CALL COUNT('load.pair', K(1, 3), N)
      END IF
C
      IF (ASKS(CASE, 'sweep')) THEN
        N = NSPD*NREL
        CALL GS_SWEEP(CASE, NWORK, WORK, 2, NSPD, NREL, X, X(1, 2),
     1    X(1, 3), X(1, 4), K, K(1, 2), X(1, 5), X(1, 6), K(1, 3),
     2    K(1, 4), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('sweep.rpm', X, NSPD)
        CALL SHOW('sweep.relief_um', X(1, 2), NREL)
        CALL SHOW('sweep.dynamic_factor', X(1, 3), N)
        CALL SHOW('sweep.estimate', X(1, 4), N)
        CALL COUNT('sweep.status', K, N)
        CALL COUNT('sweep.contact', K(1, 2), N)
        CALL SHOW('sweep.floquet_modulus', X(1, 5), N)
        CALL SHOW('sweep.residual', X(1, 6), N)
        CALL COUNT('sweep.steps', K(1, 3), N)
        CALL COUNT('sweep.periods', K(1, 4), N)
        CALL GS_RESONANCES(NSPD, X, X(1, 3), N, X(1, 7), X(1, 8), INFO,
     1    MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('resonances.peak_rpm', X(1, 7), N)
        CALL SHOW('resonances.peak_factor', X(1, 8), N)
      END IF
C
      IF (ASKS(CASE, 'optimum')) THEN
        CALL GS_OPTIMUM(CASE, NWORK, WORK, 2, NTRY, N, X, X(1, 2),
     1    X(1, 3), K, X(1, 4), X(1, 5), X(1, 6), X(1, 7), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('optimum.relief_um', X, N)
        CALL SHOW('optimum.worst_factor', X(1, 2), N)
        CALL SHOW('optimum.rpm', X(1, 3), N)
        CALL COUNT('optimum.failed', K, N)
        CALL SHOW('optimum.best_um', X(1, 4), 1)
        CALL SHOW('optimum.best_factor', X(1, 5), 1)
        CALL SHOW('optimum.best_rpm', X(1, 6), 1)
        CALL SHOW('optimum.within_um', X(1, 7), 1)
      END IF
C
      IF (ASKS(CASE, 'section')) THEN
        CALL GS_SECTION(CASE, NNODE, NELEM, X, X(1, 2), K, K(1, 2),
     1    INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('section.x_mm', X, NNODE)
        CALL SHOW('section.y_mm', X(1, 2), NNODE)
        CALL COUNT('section.element', K, 8*NELEM)
        CALL COUNT('section.tooth', K(1, 2), NELEM)
      END IF
C
      IF (ASKS(CASE, 'modal')) THEN
        CALL GS_MODES(CASE, NMODE, NNODE, X, X(1, 2), X(1, 3), X(1, 4),
     1    X(1, 5), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('modal.frequency_hz', X, NMODE)
        CALL SHOW('modal.estimate', X(1, 2), NMODE)
        CALL SHOW('modal.residual', X(1, 3), NMODE)
        CALL SHOW('modal.rim_share', X(1, 4), NMODE)
        CALL SHOW('modal.shape', X(1, 5), 2*NNODE*NMODE)
      END IF
C
      IF (ASKS(CASE, 'static')) THEN
        CALL GS_ROOT(CASE, NWORK, WORK, NPOS, NREL, X, X(1, 2),
     1    X(1, 3), X(1, 4), X(1, 5), X(1, 6), X(1, 7), X(1, 8),
     2    X(1, 9), X(1, 10), X(1, 11), X(1, 12), X(1, 13), INFO,
     3    MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('static.relief_um', X, NREL)
        CALL SHOW('static.s', X(1, 2), NPOS)
        CALL SHOW('static.radius_mm', X(1, 3), NPOS)
        CALL SHOW('static.share', X(1, 4), NPOS*NREL)
        CALL SHOW('static.sigma_mpa', X(1, 5), 2*NPOS*NREL)
        CALL SHOW('static.parts_mpa', X(1, 6), 6*NPOS*NREL)
        CALL SHOW('static.tension_mpa', X(1, 7), NREL)
        CALL SHOW('static.tension_deg', X(1, 8), NREL)
        CALL SHOW('static.compression_mpa', X(1, 9), NREL)
        CALL SHOW('static.compression_deg', X(1, 10), NREL)
        CALL SHOW('static.estimate', X(1, 11), NREL)
        CALL SHOW('static.iso_mpa', X(1, 12), 1)
        CALL SHOW('static.lewis_mpa', X(1, 13), 1)
C       The whole section at the last position and the last relief.
        CALL GS_STRESS(CASE, NWORK, WORK, NPOS, NREL, NNODE, X,
     1    X(1, 2), X(1, 3), X(1, 4), X(1, 5), INFO, MESSAG)
        CALL CHECK(INFO, MESSAG)
        CALL SHOW('stress.relief_um', X, 1)
        CALL SHOW('stress.s', X(1, 2), 1)
        CALL SHOW('stress.radius_mm', X(1, 3), 1)
        CALL SHOW('stress.share', X(1, 4), 1)
        CALL SHOW('stress.sigma_mpa', X(1, 5), 3*NNODE)
      END IF
C
      CALL GS_REPORT(CASE, ' ', NWORK, WORK, 2, ANSWER, LENGTH, INFO,
     1  MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A)') ANSWER(1:LENGTH - 1)
      END
C
      LOGICAL FUNCTION ASKS(CASE, TASK)
      CHARACTER*(*) CASE, TASK
      ASKS = INDEX(CASE, ''''//TASK//'''').GT.0
      END
C
      SUBROUTINE SHOW(NAME, X, N)
      CHARACTER*(*) NAME
      INTEGER N, I
      DOUBLE PRECISION X(*)
      WRITE (*, '(A,A,1PE25.16E3)') (NAME, ',', X(I), I = 1, N)
      END
C
      SUBROUTINE COUNT(NAME, K, N)
      CHARACTER*(*) NAME
      INTEGER N, I, K(*)
      WRITE (*, '(A,A,I12)') (NAME, ',', K(I), I = 1, N)
      END
C
      SUBROUTINE CHECK(INFO, MESSAG)
      INTEGER INFO
      CHARACTER*(*) MESSAG
      IF (INFO.EQ.0) RETURN
      WRITE (*, '(A,I2,2A)') 'info', INFO, ': ', MESSAG
      STOP 1
      END
