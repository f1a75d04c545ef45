with RobotTestingFramework.Cases; use RobotTestingFramework.Cases;

package body Plugin is

   procedure Pass is null;

   overriding procedure Run (Self : in out Test) is
   begin
      Run_Case ("pose", Pass'Access);
      Run_Case ("pose", Pass'Access);
   end Run;

end Plugin;
