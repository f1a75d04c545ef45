with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body My_Robot_Test is

   --  Connect here. A problem in Setup is an `error`: the bench is wrong, not the robot.
   overriding function Setup (Self : in out Test; Parameters : String) return Boolean is
   begin
      if Parameters /= "" then
         Self.Goal := Long_Float'Value (Argument (1));
      end if;
      return True;
   end Setup;

   --  Test here. The first problem decides the verdict.
   overriding procedure Run (Self : in out Test) is

      --  A stand-in for the robot.
      function At_Goal return Boolean is
      begin
         Self.Position := Self.Position + 15.0;
         return Self.Position >= Self.Goal;
      end At_Goal;

      procedure Wait is new Wait_Until (At_Goal);

   begin
      --  Ends the test if it takes longer than 5 s.
      Wait (5.0, "the joint at its goal");
      --  A failed check does not end the test.
      Check_Near (Self.Position, Self.Goal, 0.5, "joint");
      --  Stored with the result, and checked against the limits.
      Measure ("position", Self.Position, "deg", 0.0, 180.0);
   end Run;

   --  Leave the robot as it was. rtf always calls it.
   overriding procedure TearDown (Self : in out Test) is
   begin
      Self.Position := 0.0;
   end TearDown;

end My_Robot_Test;
