with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      Report ("going to hang");
      loop
         delay 3600.0;
      end loop;
   end Run;

end Plugin;
