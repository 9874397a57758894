C     Designs a spur-gear pair with gearsweep, as a legacy code would:
C     Fortran 77, fixed form. Prints every result with 17 digits and
C     leaves its case in legacy.nml.
C
C       gfortran legacy.f $(pkg-config --cflags --libs gearsweep)
C
      PROGRAM LEGACY
      INTEGER MAXSPD, MAXREL, MAXROW, MAXTRY, MAXWRK
      PARAMETER (MAXSPD=50, MAXREL=5, MAXROW=3000, MAXTRY=60)
      PARAMETER (MAXWRK=500)
      CHARACTER*1000 CASE
      CHARACTER*120 MESSAG
      INTEGER NSPD, NREL, NROW, NTRY, NPOS, NMODE, NNODE, NELEM
      INTEGER NHARM, NWORK, INFO
      INTEGER I, J, TEETH(2)
      INTEGER STATUS(MAXSPD, MAXREL), TOUCH(MAXSPD, MAXREL)
      INTEGER STEPS(MAXSPD, MAXREL), NPER(MAXSPD, MAXREL)
      INTEGER FAILED(MAXTRY)
      DOUBLE PRECISION WORK(MAXWRK), MODUL, WIDTH, FORCE
      DOUBLE PRECISION RADIUS(6, 2), POINT(5), PRAD(5, 2), DIST
      DOUBLE PRECISION ANGLE(2), RATIO, PITCH, LASH
      DOUBLE PRECISION LOAD, MASS(2), STIFF, FREQ, TURN, SHARED
      DOUBLE PRECISION MREL(MAXROW), S(MAXROW), KPAIR(MAXROW)
      DOUBLE PRECISION KMESH(MAXROW), E(MAXROW), SHARE(MAXROW)
      DOUBLE PRECISION STE(MAXROW)
      DOUBLE PRECISION RPM(MAXSPD), RELIEF(MAXREL)
      DOUBLE PRECISION DF(MAXSPD, MAXREL), EST(MAXSPD, MAXREL)
      DOUBLE PRECISION FLOQ(MAXSPD, MAXREL), RES(MAXSPD, MAXREL)
      DOUBLE PRECISION VREL(MAXTRY), VDF(MAXTRY), VRPM(MAXTRY)
      DOUBLE PRECISION BEST, BESTDF, BRPM, WITHIN
      INTEGER NDAMP, NTONG, MAXCHG, NKEEP
      PARAMETER (NDAMP=2, NTONG=2, MAXCHG=20, NKEEP=8)
      INTEGER NCHG, SENSE(MAXSPD*NDAMP), CSTAT(2, MAXCHG)
      INTEGER CPER(2, MAXCHG)
      DOUBLE PRECISION ZETA(NDAMP), FLMAX(MAXSPD*NDAMP), CLOSE(NTONG)
      DOUBLE PRECISION CLRPM(NTONG), EDGE(2*NDAMP*NTONG)
      DOUBLE PRECISION CRPM(2, MAXCHG), CDF(2, MAXCHG), X(MAXSPD)
      DOUBLE PRECISION V(MAXSPD), XS(NKEEP*MAXSPD), VS(NKEEP*MAXSPD)
      DOUBLE PRECISION LYAP(MAXSPD)
      DATA ZETA /0D0, 0.01D0/
C
C     The case, from the variables of this program.
      MODUL = 3.18D0
      WIDTH = 25.4D0
      TEETH(1) = 25
      TEETH(2) = 31
      FORCE = 7010D0
      WRITE (CASE, 100) MODUL, WIDTH, TEETH, FORCE
  100 FORMAT ('&case tasks = ''mesh'', ''sweep'', ''optimum'' / ',
     1  '&pair module_mm = ', F6.3, ' face_width_mm = ', F8.3, ' / ',
     2  '&pinion teeth = ', I4, ' effective_mass_kg = 0.8 / ',
     3  '&gear teeth = ', I4, ' effective_mass_kg = 1.1 / ',
     4  '&load normal_force_n = ', F10.2, ' / ',
     5  '&relief amount_um = 0, 12.5, 20 / ',
     6  '&mesh model = ''fe'' / &section elements_across = 6 / ',
     7  '&sweep rpm_first = 2000 rpm_last = 16000 rpm_step = 500 /')
      OPEN (10, FILE='legacy.nml')
      WRITE (10, '(A)') CASE
      CLOSE (10)
C
C     Sizes first, so that the arrays are known to be large enough.
      CALL GS_SIZES(CASE, ' ', NSPD, NREL, NROW, NTRY, NPOS, NMODE,
     1  NNODE, NELEM, NHARM, NWORK, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      IF (NSPD.GT.MAXSPD .OR. NREL.GT.MAXREL .OR. NROW.GT.MAXROW .OR.
     1  NTRY.GT.MAXTRY .OR. NWORK.GT.MAXWRK) STOP 'ARRAYS TOO SMALL'
C
      CALL GS_GEOMETRY(CASE, RADIUS, POINT, PRAD, DIST, ANGLE, RATIO,
     1  PITCH, LASH, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL SHOW('radius', RADIUS, 12)
      CALL SHOW('point', POINT, 5)
      CALL SHOW('point_radius', PRAD, 10)
      WRITE (*, 200) 'distance', DIST
      CALL SHOW('angle', ANGLE, 2)
      WRITE (*, 200) 'ratio', RATIO
      WRITE (*, 200) 'pitch', PITCH
      WRITE (*, 200) 'backlash', LASH
C
C     The finite elements run here, and in no call that is given WORK.
      CALL GS_PREPARE(CASE, ' ', NWORK, WORK, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL GS_MOTION(CASE, NWORK, WORK, LOAD, MASS, STIFF, FREQ, TURN,
     1  SHARED, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, 200) 'load', LOAD
      CALL SHOW('mass', MASS, 2)
      WRITE (*, 200) 'stiffness', STIFF
      WRITE (*, 200) 'frequency', FREQ
      WRITE (*, 200) 'turn', TURN
      WRITE (*, 200) 'shared', SHARED
C
      CALL GS_MESH(CASE, NWORK, WORK, NROW, MREL, S, KPAIR, KMESH, E,
     1  SHARE, STE, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      DO 10 I = 1, NROW
        WRITE (*, 200) 'mesh', MREL(I), S(I), KPAIR(I), KMESH(I), E(I),
     1    SHARE(I), STE(I)
   10 CONTINUE
C
C     The arrays may be larger than need be: their true sizes go in.
      CALL GS_SWEEP(CASE, NWORK, WORK, 2, MAXSPD, MAXREL, RPM, RELIEF,
     1  DF, EST, STATUS, TOUCH, FLOQ, RES, STEPS, NPER, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      DO 30 J = 1, NREL
        DO 20 I = 1, NSPD
          WRITE (*, 200) 'sweep', RELIEF(J), RPM(I), DF(I, J),
     1      EST(I, J), FLOQ(I, J), RES(I, J)
          WRITE (*, '(A,4(A,I6))') 'status', ',', STATUS(I, J), ',',
     1      TOUCH(I, J), ',', STEPS(I, J), ',', NPER(I, J)
   20   CONTINUE
   30 CONTINUE
C
      CALL GS_OPTIMUM(CASE, NWORK, WORK, 2, MAXTRY, NTRY, VREL, VDF,
     1  VRPM, FAILED, BEST, BESTDF, BRPM, WITHIN, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      DO 40 I = 1, NTRY
        WRITE (*, 200) 'vcurve', VREL(I), VDF(I), VRPM(I)
   40 CONTINUE
      WRITE (*, 200) 'best', BEST, BESTDF, BRPM, WITHIN
C
C     The same speeds: where less damping would be too little, what a
C     slow run up meets, and what is seen of it once a mesh period.
      CALL GS_STABILITY(CASE, NWORK, WORK, NSPD, RPM, NDAMP, ZETA,
     1  NTONG, FLMAX, SENSE, CLOSE, CLRPM, EDGE, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL SHOW('modulus', FLMAX, NSPD*NDAMP)
      WRITE (*, '(A,A,I6)') ('sense', ',', SENSE(I), I = 1, NSPD*NDAMP)
      CALL SHOW('closing', CLOSE, NTONG)
      CALL SHOW('closing', CLRPM, NTONG)
      CALL SHOW('edge', EDGE, 2*NDAMP*NTONG)
      CALL GS_FOLLOW(CASE, NWORK, WORK, 1, NSPD, RPM, 0.02D0, 1D-6,
     1  MAXCHG, NCHG, CRPM, CDF, CSTAT, CPER, DF, EST, STATUS, TOUCH,
     2  FLOQ, NPER, X, V, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      WRITE (*, '(A,A,I6)') 'changes', ',', NCHG
      DO 50 I = 1, NSPD
        WRITE (*, 200) 'follow', RPM(I), DF(I, 1), EST(I, 1),
     1    FLOQ(I, 1), X(I), V(I)
   50 CONTINUE
      CALL GS_STROBE(CASE, NWORK, WORK, 1, NSPD, RPM, X(1), V(1), 20,
     1  NKEEP, XS, VS, LYAP, STATUS, NPER, INFO, MESSAG)
      CALL CHECK(INFO, MESSAG)
      CALL SHOW('strobe', XS, NKEEP*NSPD)
      CALL SHOW('strobe', VS, NKEEP*NSPD)
      CALL SHOW('exponent', LYAP, NSPD)
  200 FORMAT (A, 7(:, ',', 1PE25.16E3))
      END
C
      SUBROUTINE SHOW(NAME, X, N)
      CHARACTER*(*) NAME
      INTEGER N, I
      DOUBLE PRECISION X(N)
      DO 10 I = 1, N
        WRITE (*, '(A,A,1PE25.16E3)') NAME, ',', X(I)
   10 CONTINUE
      END
C
      SUBROUTINE CHECK(INFO, MESSAG)
      INTEGER INFO
      CHARACTER*(*) MESSAG
      IF (INFO.EQ.0) RETURN
      WRITE (*, '(A,I2,2A)') 'info', INFO, ': ', MESSAG
      IF (INFO.NE.4) STOP 1
      END
