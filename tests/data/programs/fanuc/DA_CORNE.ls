/PROG  DA_CORNE
/ATTR
COMMENT = "dualarm_pin";
DEFAULT_GROUP = 1,1,*,*,*;
/MN
   1:!task corner ;
   2:J P[1] 10% FINE ;
   3:J P[2] 120msec CNT100 ;
   4:J P[3] 120msec FINE ;
/POS
P[1]{
   GP1:
    UF : 0, UT : 1,
    J1 = -2.00000 deg, J2 = -1.87500 deg, J3 = -1.75000 deg,
    J4 = -1.62500 deg, J5 = -1.50000 deg, J6 = -1.37500 deg
   GP2:
    UF : 0, UT : 1,
    J1 = -1.25000 deg, J2 = -1.12500 deg, J3 = -1.00000 deg,
    J4 = -0.87500 deg, J5 = -0.75000 deg, J6 = -0.62500 deg
};
P[2]{
   GP1:
    UF : 0, UT : 1,
    J1 = -0.50000 deg, J2 = -0.37500 deg, J3 = -0.25000 deg,
    J4 = -0.12500 deg, J5 = 0.00000 deg, J6 = 0.12500 deg
   GP2:
    UF : 0, UT : 1,
    J1 = 0.25000 deg, J2 = 0.37500 deg, J3 = 0.50000 deg,
    J4 = 0.62500 deg, J5 = 0.75000 deg, J6 = 0.87500 deg
};
P[3]{
   GP1:
    UF : 0, UT : 1,
    J1 = 1.00000 deg, J2 = 1.12500 deg, J3 = 1.25000 deg,
    J4 = 1.37500 deg, J5 = 1.50000 deg, J6 = 1.62500 deg
   GP2:
    UF : 0, UT : 1,
    J1 = 1.75000 deg, J2 = 1.87500 deg, J3 = 2.00000 deg,
    J4 = 2.12500 deg, J5 = 2.25000 deg, J6 = 2.37500 deg
};
/END
