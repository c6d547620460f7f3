MODULE da_corner_T_ROB1
! task corner
PERS tasks all_tasks{2} := [["T_ROB1"],["T_ROB2"]];
VAR syncident sync1;
VAR syncident sync2;
TASK PERS speeddata vfeed := [100,500,5000,1000];
PROC main()
  MoveAbsJ [[-2.00000,-1.87500,-1.75000,-1.62500,-1.50000,-1.37500],[9E9,9E9,9E9,9E9,9E9,9E9]]\NoEOffs,v100,fine,tool0;
  SyncMoveOn sync1, all_tasks;
  MoveAbsJ [[-0.50000,-0.37500,-0.25000,-0.12500,0.00000,0.12500],[9E9,9E9,9E9,9E9,9E9,9E9]]\ID:=10\NoEOffs,vfeed\T:=0.12000,z1,tool0;
  MoveAbsJ [[1.00000,1.12500,1.25000,1.37500,1.50000,1.62500],[9E9,9E9,9E9,9E9,9E9,9E9]]\ID:=20\NoEOffs,vfeed\T:=0.12000,fine,tool0;
  SyncMoveOff sync2;
ENDPROC
ENDMODULE
