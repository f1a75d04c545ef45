with Ada.Text_IO; use Ada.Text_IO;
with RobotTestingFramework.Session; use RobotTestingFramework.Session;

package body Plugin is

   overriding procedure Run (Self : in out Test) is
      Trace : File_Type;
   begin
      Create (Trace, Out_File, "written-trace.csv");
      Put_Line (Trace, "t,q");
      Put_Line (Trace, "0,1");
      Close (Trace);
      Attach ("written-trace.csv", "trace.csv", "text/csv");
   end Run;

end Plugin;
