with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;

package body Plugin is

   procedure Joint_0 is
   begin
      Report ("moved");
   end Joint_0;

   procedure Joint_1 is
   begin
      Check (False, "joint 1 moves");
      Report ("still here");
   end Joint_1;

   procedure Joint_2 is
   begin
      Check (True, "joint 2 moves");
   end Joint_2;

   overriding procedure Run (Self : in out Test) is
   begin
      Run_Case ("joint 0", Joint_0'Access, (1 => Named ("joint", 0)));
      Run_Case ("joint 1", Joint_1'Access);
      Run_Case ("joint 2", Joint_2'Access);
   end Run;

end Plugin;
