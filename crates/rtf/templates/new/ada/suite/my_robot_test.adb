with Ada.Long_Float_Text_IO;
with Ada.Text_IO;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body My_Robot_Test is

   --  Reads the position from the stand-in for the robot.
   function Position return Long_Float is
      File    : Ada.Text_IO.File_Type;
      Degrees : Long_Float;
   begin
      Ada.Text_IO.Open (File, Ada.Text_IO.In_File, Fixture_Value ("simulator.state"));
      Ada.Long_Float_Text_IO.Get (File, Degrees);
      Ada.Text_IO.Close (File);
      return Degrees;
   end Position;

   --  Connect here. A problem in Setup is an `error`: the bench is wrong, not the robot.
   overriding function Setup (Self : in out Test; Parameters : String) return Boolean is
   begin
      Self.Goal := Long_Float'Value (Parameters); -- param in the suite
      return True;
   end Setup;

   --  Test here. The first problem decides the verdict.
   overriding procedure Run (Self : in out Test) is

      function At_Goal return Boolean is (Position >= Self.Goal);
      procedure Wait is new Wait_Until (At_Goal);

   begin
      --  Ends the test if it takes longer than 10 s.
      Wait (10.0, "the joint at its goal");
      --  A failed check does not end the test.
      Check_Near (Position, Self.Goal, 0.5, "joint");
      --  Stored with the result, and checked against the limits.
      Measure ("position", Position, "deg", 0.0, 180.0);
   end Run;

   --  Leave the robot as it was. rtf always calls it.
   overriding procedure TearDown (Self : in out Test) is null;

end My_Robot_Test;
