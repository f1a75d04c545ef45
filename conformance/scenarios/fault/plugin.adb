with Ada.Text_IO;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Faults;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   package Faults renames RobotTestingFramework.Faults;

   function Ticks return Natural is
      File : Ada.Text_IO.File_Type;
   begin
      Ada.Text_IO.Open (File, Ada.Text_IO.In_File, "tick");
      return Count : constant Natural := Natural'Value (Ada.Text_IO.Get_Line (File)) do
         Ada.Text_IO.Close (File);
      end return;
   end Ticks;

   function Stands return Boolean is
      Before : constant Natural := Ticks;
   begin
      Sleep (0.15);
      return Ticks = Before;
   end Stands;

   procedure Wait_For_Tick is
      Before : constant Natural := Ticks;
      function Runs return Boolean is (Ticks > Before);
      procedure Wait is new Wait_Until (Runs);
   begin
      Wait (30.0, "the camera to run");
   end Wait_For_Tick;

   overriding procedure Run (Self : in out Test) is
   begin
      Faults.Inject ("drop");
      Check (Stands, "the camera stands");
      Faults.Remove ("drop");
      Faults.Remove ("drop");
      Wait_For_Tick;
      Faults.Inject ("drop");
      Check (Stands, "the camera stands again");
      Faults.Inject ("drop");
      Report ("not reached");
   end Run;

end Plugin;
