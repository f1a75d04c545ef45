with Arm_Tests;
with AUnit.Test_Caller;

package body Arm_Suite is

   package Caller is new AUnit.Test_Caller (Arm_Tests.Gripper);

   Arm   : aliased Arm_Tests.Arm_Case;
   Bench : aliased Arm_Tests.Bench_Case;

   function Suite return AUnit.Test_Suites.Access_Test_Suite is
      use AUnit.Test_Suites;
      All_Tests : constant Access_Test_Suite := New_Suite;
      Grippers  : constant Access_Test_Suite := New_Suite;
   begin
      All_Tests.Add_Test (Arm'Access);
      All_Tests.Add_Test (Bench'Access);
      Grippers.Add_Test (Caller.Create ("Gripper opens", Arm_Tests.Opens'Access));
      Grippers.Add_Test (Caller.Create ("Gripper closes", Arm_Tests.Closes'Access));
      All_Tests.Add_Test (Grippers);
      return All_Tests;
   end Suite;

end Arm_Suite;
