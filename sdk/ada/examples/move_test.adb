with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Move_Test is

   overriding function Setup (Self : in out Test; Parameters : String) return Boolean is
   begin
      if Parameters /= "" then
         Self.Goal := Long_Float'Value (Argument (1));
      end if;
      return True;
   end Setup;

   overriding procedure Run (Self : in out Test) is

      function At_Goal return Boolean is
      begin
         Self.Position := Self.Position + 0.01;
         return Self.Position >= Self.Goal;
      end At_Goal;

      procedure Wait is new Wait_Until (At_Goal);

   begin
      Report ("moving to" & Self.Goal'Image & " rad");
      Wait (5.0, "the joint at its goal");
      Check_Near (Self.Position, Self.Goal, 0.1, "elbow");
   end Run;

   overriding procedure TearDown (Self : in out Test) is
   begin
      Self.Position := 0.0;
   end TearDown;

end Move_Test;
